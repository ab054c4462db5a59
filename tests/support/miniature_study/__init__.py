"""A folder that tests add to the studies: its only study has nothing but `rows` and `study`."""
