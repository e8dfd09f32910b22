"""A team of robots that the engine does not integrate itself: where they are, whether they may drive, what they hear.

opening      finds teams and sources of poses by entry point
tracking     which poses are believed, and where a robot is by the time that a command reaches it
supervision  the pure step: armed or not, stale, lost, standing, disobedient, from a report and the state before
guard        what the safety filter must know: robots that stand count as obstacles, clearances grow by the budget
driver       the live team: makes a report in each control period, sends what the robots shall do
"""
