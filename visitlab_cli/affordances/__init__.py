"""What a social module believes of its actions: learned, true, what it would do, with fewer too; and pictures of it."""
