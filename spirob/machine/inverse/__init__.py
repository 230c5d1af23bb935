"""The inverse model: the effort that a measured motion asks for.

problem.py, equations.py  the model on the trials, and its equations
motion.py       the motion of all trials in a row, and what remembers along it
body.py         the body behind the motor
numbers.py      what is fitted
scaling.py, shapes.py
                the library's numbers at this size; where they start, and which waves are one
kernel_loop.py  effects along whole recordings; back through those between effort and torque
swings.py       what effects begin with
"""
