"""One file for a kind of figures. Each section has `measure_…(bench)`, whose result is JSON, and `…_page(data)`, which makes Markdown of it; with plots,
`…_plots(data)`: {file name: SVG}. They are put together in registry.py."""
