"""What commands share: options, help, completion, running a plan, tables in the terminal."""
