"""The source of members.

`draws` maps points of sequences to distributions, `tables` reads the tables of users, and `members` makes scenes and cases of
both.
"""
