"""Ten findings that every user of pymunk or MuJoCo should know: what the index begins with."""
