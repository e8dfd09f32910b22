"""Live streams over the Lab Streaming Layer."""
