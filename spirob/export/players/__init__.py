"""Scripts that play logs in what was exported; each runs alone, and imports nothing of ours.

alone.py                 the script that is started; it loads one of the others
arm.py, arm_led.py       trials of an arm, in plain MuJoCo and in plain MJCF
mujoco.py, bam.py, c.py  logs of a rig, in each of these formats
"""
