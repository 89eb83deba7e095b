#!/usr/bin/env bash
# Renders the pictures of the documentation, all of them, with the program itself.
#   docs/render_pictures.sh [FOLDER OF THE scancast PROGRAM] [FOLDER OF REAL SCANS]
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
bin=${1:-$root/build/release/bin}
scans=${2:-$root/../shared/data}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$bin/scancast" generate town --points 20M --origin 0,0,0 -o "$work/town.las"
render() { "$bin/scancast" render "$1" -o "$root/docs/images/$2.jpg" --width 1280 --height 720 --quality 85 "${@:3}"; }

render "$work/town.las" town
render "$work/town.las" square --eye=-1,-15,2.2 --target=0,-8.6,2.4
render "$work/town.las" intensity --color intensity --colormap viridis --shading eyedome

# Geoffrey Marchal's statue of Guanyin (CC BY 4.0), where it is at hand.
if [ -e "$scans/ply/guanyin-statue.ply" ]; then
    render "$scans/ply/guanyin-statue.ply" statue --eye=0.35,0.72,1.65 --target=0,0.62,0 --up=0,1,0
fi
