"""What pymunk holds each joint by: one file a joint."""
