"""Sources of poses: what tells where robots are, where the team itself does not.

mocap   motion capture: OptiTrack, Vicon, Qualisys, VRPN
"""
