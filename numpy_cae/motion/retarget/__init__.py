"""From any rig to the twenty joints and back."""
