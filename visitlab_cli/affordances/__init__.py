"""What a social module believes of its actions: learned, true, what it would do, and with fewer; pictures of it."""
