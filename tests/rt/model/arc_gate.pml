/* SPDX-License-Identifier: Apache-2.0
 * Arc and motion between the session (rt/weld_session.cpp), a bus that may lose frames or be cut,
 * and a robot that keeps its silence limit (lib/link/receiver.cpp).
 *
 * Time is counted in cycles. In each cycle the host takes in what may have gone wrong, decides, and
 * sends either an abort or a heartbeat with its permit; the bus delivers or loses it; the robot
 * acts.
 *
 * Checked: no permit leaves the host in or after the cycle that latched a fault; the robot's arc is
 * off at most LIMIT cycles after a fault, whatever the bus loses; the arc never burns while the
 * robot does not move; without a fresh edge of the operator's condition no arc comes back.
 */
#define LIMIT 4 /* the robot's silence limit, in cycles */

mtype = { kHeartbeat, kAbort, kNothing };

bool fault = false;      /* latched */
bool enable = false;     /* the operator's condition */
bool edge = false;       /* it came anew since the last disarming */
bool armed = false;
bool permit = false;

mtype frame = kNothing;  /* what is on the wire in this cycle */
bool frame_permit = false;

bool arc = false;        /* the robot's side */
bool moving = false;
bool stopping = false;
byte silent = 0;
byte since_fault = 0;
byte cycles = 0;
#define CYCLES 24

inline disturb() {
  if
  :: enable = true; edge = true
  :: enable = false; edge = false
  :: skip
  fi;
  lost_condition = false;
  if
  :: armed -> lost_condition = true /* any condition of either gate */
  :: skip
  fi
}

inline host() {
  if
  :: lost_condition && !fault -> fault = true; armed = false; permit = false; since_fault = 0
  :: else -> skip
  fi;
  if
  :: !enable && armed -> armed = false; permit = false
  :: else -> skip
  fi;
  if
  :: !armed && !fault && enable && edge && !moving -> armed = true; edge = false
  :: fault && !arc && !moving && !enable -> fault = false /* reset, with the operator away */
  :: else -> skip
  fi;
  if
  :: armed && !fault -> permit = true
  :: else -> permit = false
  fi;
  if
  :: fault -> frame = kAbort
  :: else -> frame = kHeartbeat
  fi;
  frame_permit = permit;
  assert(!(fault && frame_permit))
}

inline bus() {
  if
  :: frame = kNothing /* lost, cut, damaged: the robot hears nothing */
  :: skip
  fi
}

inline robot() {
  if
  :: frame == kNothing -> silent++
  :: else -> silent = 0
  fi;
  if
  :: frame == kAbort || silent >= LIMIT -> arc = false; stopping = moving
  :: frame == kHeartbeat && frame_permit && !stopping -> moving = true; arc = true
  :: frame == kHeartbeat && !frame_permit -> arc = false; stopping = moving
  :: else -> skip
  fi;
  if
  :: silent > LIMIT -> silent = LIMIT
  :: else -> skip
  fi;
  if
  :: stopping && !arc -> moving = false; stopping = false
  :: stopping && !arc -> skip /* still on its ramp */
  :: else -> skip
  fi;
  assert(!(arc && !moving));
  if
  :: fault && since_fault < 255 -> since_fault++
  :: else -> skip
  fi;
  assert(!(fault && since_fault > LIMIT && arc))
}

init {
  bool lost_condition = false;
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
