"""Teams of robots that hear velocities: each module is a way to reach them.

mqtt   robots behind an MQTT broker
udp    robots, or a program in front of them, that hear and send JSON datagrams
relay  a program on the robot's side that stops the wheels on silence
"""
