"""The construction of each kind of joint in MuJoCo."""
