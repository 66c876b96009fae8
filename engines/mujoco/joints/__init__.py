"""What MuJoCo holds each joint by: one file, or one folder, a joint."""
