"""The tablet server: the page that the teacher opens, the live figure over a socket, and the state of the room."""
