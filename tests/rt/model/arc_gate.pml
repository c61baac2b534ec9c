/* SPDX-License-Identifier: Apache-2.0
 * Arc and motion between the session (rt/core/weld_session*.cpp), a bus that may lose frames either
 * way, and a robot that keeps its silence limit (lib/src/link/receiver*.cpp).
 *
 * Time is counted in cycles. In each cycle the world changes, the host takes it in, decides, and
 * sends either an abort or a heartbeat with its permit; the bus delivers or loses it; the robot
 * acts, and its ramp or its path may come to an end.
 *
 * Checked, each by an assertion of its own:
 *   PERMIT  no permit leaves the host in or after the cycle that latched a fault;
 *   LATE    the robot's arc is off at most LIMIT cycles after a fault, whatever the bus loses;
 *   STANDS  the arc never burns while the torch stands;
 *   EDGE    the session arms only on an edge of the operator's enable that came after the last
 *           disarming, fault or reset.
 * Each can fail: check.sh breaks one rule after the other (MUTANT) and wants spin to find it.
 */
#define LIMIT 4 /* the silence limit of both sides, in cycles */
#define CYCLES 20
#define MUTANTS 5
#ifndef MUTANT
#define MUTANT 0
#endif

mtype = { kHeartbeat, kAbort, kNothing };

bool enable = false;     /* the operator's condition */
bool fresh = false;      /* it rose since the last disarming: the truth that EDGE compares with */
bool lost_condition = false;

bool fault = false;      /* latched */
bool edge = false;       /* what the session believes of `fresh` */
bool armed = false;
bool permit = false;
byte deaf = 0;           /* cycles since the host heard of the robot */

mtype frame = kNothing;  /* what is on the wire in this cycle */
bool frame_permit = false;

bool arc = false;        /* the robot's side */
bool moving = false;
bool stopping = false;
byte silent = 0;
byte since_fault = 0;
byte cycles = 0;

inline disturb() {
  if
  :: !enable -> enable = true; fresh = true; edge = true
  :: enable -> enable = false; fresh = false; edge = false
  :: skip
  fi;
  lost_condition = false;
  if
  :: armed -> lost_condition = true /* any condition of the gates but the robot's silence */
  :: skip
  fi;
  if
  :: deaf = 0
  :: armed && deaf <= LIMIT -> deaf++ /* its status was lost */
  fi
}

inline forget() {
  armed = false;
  permit = false;
  fresh = false
}

inline host() {
  if
  :: armed && !fault && (lost_condition || deaf > LIMIT) -> fault = true; forget(); since_fault = 0
  :: armed && !fault && !(lost_condition || deaf > LIMIT) && !enable -> forget() /* disarmed */
  :: else -> skip
  fi;
  if
  :: fault && !arc && !moving -> /* the operator's reset */
     fault = false;
     fresh = false;
     if
     :: MUTANT == 5 -> skip
     :: else -> edge = false
     fi
  :: !armed && !fault && enable && (edge || MUTANT == 4) && !moving ->
     assert(fresh); /* EDGE */
     armed = true;
     edge = false;
     fresh = false;
     deaf = 0
  :: skip
  fi;
  permit = armed && (!fault || MUTANT == 1);
  if
  :: fault && MUTANT == 1 -> permit = true
  :: else -> skip
  fi;
  if
  :: fault -> frame = kAbort
  :: else -> frame = kHeartbeat
  fi;
  frame_permit = permit;
  assert(!(fault && frame_permit)) /* PERMIT */
}

inline bus() {
  if
  :: frame = kNothing /* lost, cut, damaged: the robot hears nothing */
  :: skip
  fi
}

inline stop() {
  stopping = moving;
  if
  :: MUTANT == 3 -> skip /* the arc follows the motion */
  :: else -> arc = false
  fi
}

inline robot() {
  if
  :: frame == kNothing && silent < LIMIT -> silent++
  :: frame != kNothing -> silent = 0
  :: else -> skip
  fi;
  if
  :: frame == kAbort || (silent >= LIMIT && MUTANT != 2) -> stop()
  :: frame == kHeartbeat && !frame_permit -> stop()
  :: frame == kHeartbeat && frame_permit && !stopping -> moving = true; arc = true
  :: else -> skip
  fi;
  if
  :: stopping -> moving = false; stopping = false /* the ramp ends now, */
  :: moving && !stopping -> moving = false; arc = false /* or the path does, */
  :: skip /* or neither. */
  fi;
  assert(!(arc && !moving)); /* STANDS */
  if
  :: fault && since_fault < 255 -> since_fault++
  :: else -> skip
  fi;
  assert(!(fault && since_fault > LIMIT && arc)); /* LATE */
  if
  :: arc && !moving -> arc = false
  :: else -> skip
  fi
}

init {
  do
  :: cycles < CYCLES ->
     disturb();
     host();
     bus();
     robot();
     cycles++
  :: else -> break
  od
}
