"""What a social module believes of its actions: learned, true, what it would do; and the pictures of it."""
