"""Trees of links with controllers and stops: a hybrid system, whose equations change at events and at instants of controllers.

`signals` has the values of signals and the times at which controllers act, `sampled` the laws of controllers with a rate, and
`cells` what is linear in pieces: saturation and elastic stops. `equations` writes the equations of a tree with all its modes,
`phases` evaluates them in any arithmetic, `closing` decides which joints stay at rest, and `impacts` computes impulses.
`following` follows the motion from event to event, `shadows` nudged motions beside it, from which `measuring` takes the growth
of errors, and `deciding` refuses motions whose errors may change the order or the number of their events. `acting`
finds the rigid stops that a motion reaches, which are all that is followed.
"""
