"""What several commands share: options, reading and changing motions, output."""
