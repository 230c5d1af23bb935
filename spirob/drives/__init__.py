"""Drives other than C620-style ones, each a DBC file and a short description beside it.

    codec.py        messages of a DBC file, compiled where their signals lie on bytes; voltages as a
                    command payload, for drives that take them
    description.py  which message and signal is which motor's command, angle, speed ...
    drive.py        the drive: commands out, its frames in, as C620-style frames, one cycle or a
                    whole log at a time, on a bus that is fast enough

The program speaks one language, that of `spirob.can_protocol`: currents, or voltages, and feedback
in counts.  A drive translates it to what is on the bus and back; a log keeps what was on the bus.
"""

from spirob.drives.drive import Drive, Translator, find_drive

__all__ = ["Drive", "Translator", "find_drive"]
