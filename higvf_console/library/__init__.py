"""The public interface of the method: checked, converted, documented. `higvf_console` exports its names.

hazards, paths, setups, scenarios    what a run is made of, from Python
filtering, controller, fields        the method on positions of one's own
stepping, running                    whole runs
records                              what every record is checked for
engine                               the one place that calls the compiled engine
"""
