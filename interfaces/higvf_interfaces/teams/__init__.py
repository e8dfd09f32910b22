"""Teams of robots that hear velocities: each module is a way to reach them.

mqtt   robots behind an MQTT broker
relay  a program on the robot's side that stops the wheels on silence
"""
