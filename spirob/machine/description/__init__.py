"""What a rig is, as its owner describes it.

rig.py         the whole description
columns.py     columns of its logs, how they are filtered, which rows count
controller.py  what the controller asks for under which a log was made
model_file.py  the body behind the motor, of a model in MuJoCo's format
"""
