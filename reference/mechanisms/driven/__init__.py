"""One joint on the world with a controller or stops, whose equation is linear between events: its motion in closed form.

- `form`: open this first. The motion at given instants, with bounds of its errors.
- `following`: the motion from event to event. `sampled`: the law at the instants of a controller. `rebounds`: rebounds from a
  rigid stop that accumulate.
- `modes`: the linear systems between events, and the conditions under which they last; continuous laws, saturation and stops.
- `decisions`: the mode that follows from a state.
- `events`: the first instant at which a condition ceases to hold.
- `linear`: steps of linear systems. `signals`: targets and efforts over time.
"""
