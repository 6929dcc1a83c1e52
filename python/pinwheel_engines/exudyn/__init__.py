"""exudyn: kinematic tree or constrained bodies with the shared contact law, or exudyn's own contact."""
