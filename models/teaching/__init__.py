"""What is taught: of each action its standard, its phases, its faults and what to say about them."""
