"""Where robots are, told by what watches them: sources of poses for teams that do not know their own.

mocap        `--poses mocap=...`: motion capture by OptiTrack, Vicon, Qualisys, VRPN
camera       `--poses camera=...`: tags on the robots, seen by an overhead camera
capture      frames of a video file, a camera or a stream; the newest one only
tags         tags in a frame, found at half size and refined at full
calibration  files of lens and floor: from pixels to metres
floor_view   the floor as the camera has it now, and the picture of it from straight above
making       makes a floor file; `python -m higvf_interfaces.poses`
"""
