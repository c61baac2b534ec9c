/* SPDX-License-Identifier: Apache-2.0
 * The exchange of rt/latest_value.hpp. Three slots, each two words long, so that a torn copy would
 * show. The exchange of `between` is atomic; every access to a slot is a step of its own.
 *
 * Checked: a slot is never written while it is read, no value is torn, none comes twice, none goes
 * back, and after the writer's end the reader has got the last one.
 */
#define VALUES 5
#define FRESH  4

byte low[3];
byte high[3];
byte between = 2;
byte writing = 255; /* the slot that is being written, or read; 255: none */
byte reading = 255;
bool written = false;
byte last_read = 0;

inline exchange(mine, with) {
  atomic {
    byte_old = between;
    between = with;
    mine = byte_old & 3;
    byte_old = 0
  }
}

proctype Writer() {
  byte back = 0;
  byte value = 1;
  byte byte_old;
  do
  :: value <= VALUES ->
     writing = back;
     assert(reading != back);
     low[back] = value;
     high[back] = value;
     writing = 255;
     exchange(back, (back | FRESH));
     value++
  :: else -> break
  od;
  written = true
}

proctype Reader() {
  byte front = 1;
  byte byte_old;
  byte a;
  byte b;
  bool ended;
  do
  :: ended = written;
     if
     :: (between & FRESH) ->
        exchange(front, front);
        reading = front;
        assert(writing != front);
        a = low[front];
        b = high[front];
        reading = 255;
        assert(a == b);
        assert(a > last_read);
        last_read = a
     :: else ->
        if
        :: ended -> break
        :: else -> skip
        fi
     fi
  od;
  assert(last_read == VALUES)
}

init {
  atomic {
    run Writer();
    run Reader()
  }
}
