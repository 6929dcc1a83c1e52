"""MuJoCo: bodies, joints and time integration by MuJoCo, with the shared contact law or with its own contact."""
