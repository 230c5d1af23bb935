"""Everything between a controller and motors on a CAN bus, but for the frames' own language.

description.py  which message and signal is which motor's command, angle, speed ...; the messages of
                a DBC file, compiled where their signals lie on bytes
drive.py        a kind of drive: commands out, its frames in, one cycle or a whole log at a time, on
                a bus that is fast enough; those in `drives/`, each a DBC file and a description
bus.py          a bus through python-can: opened, listened to without saying anything, and checked
robot.py        a robot with real drives, and its claim on the computer that runs its loop
limits.py       limits that no command may leave; reasons to stop, one function each; Ctrl-C and
                SIGTERM between two cycles
motor.py        what a drive last said, in SI
guard.py        the robot behind its limits, real, emulated or simulated: armed by hand, zero
                current first

The program speaks one language, that of `spirob.can_protocol`: currents, or voltages, and feedback
in counts.  A drive translates it to what is on the bus and back; a log keeps what was on the bus.
"""
