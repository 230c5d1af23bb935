"""What logs of messages share: bags of ROS, MCAP, CAN.

fields.py    a number at a place in a message, `position[elbow]`, and which there are
decoders.py  bytes to messages: JSON, protobuf, ROS
table.py     several series, each with stamps of its own, on one time; topics of a log to a table
"""
