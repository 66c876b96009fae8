"""Released versions of engines beside one another: installed apart, each run in a process of its own."""
