"""The person's side: commands, chat, dialogue, replies and the demo home."""
