"""The full-screen chat, the only user of textual; `assistant.ui.app.ChatApp` is its door."""
