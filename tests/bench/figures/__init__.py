"""What tests/bench/all.py is made of: the sections of docs/performance.md, each with what measures it. registry.py lists them."""
