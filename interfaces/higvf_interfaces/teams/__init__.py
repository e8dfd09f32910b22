"""Teams of robots that hear velocities: each module is a way to reach them.

udp    robots, or a program in front of them, that hear and send JSON datagrams
"""
