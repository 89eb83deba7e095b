#!/usr/bin/env bash
# Renders the pictures of the documentation, all of them, with the program itself.
#   docs/render_pictures.sh [FOLDER OF THE scancast PROGRAM] [FOLDER OF REAL SCANS]
# The contact sheet of docs/first-sight.md alone: docs/render_pictures.sh --first-sight [FOLDER OF THE scancast PROGRAM]
set -euo pipefail
only=
if [ "${1:-}" = --first-sight ]; then only=$1; shift; fi
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
bin=${1:-$root/build/release/bin}
scans=${2:-$root/../shared/data}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Generated scans as they are shown when nobody says anything; ffmpeg makes a JPEG of the sheet.
sight() {  # SCENE POINTS ENDING
    "$bin/scancast" generate "$1" --points "$2" -o "$work/$1.$3" --quiet
    sights+=("$work/$1.$3")
}
sights=()
sight town 2M las
for scene in room statue bridge; do sight "$scene" 1M ply; done
sight torus 300k ply
for scene in cube sphere; do sight "$scene" 100k ply; done
sight sign 300k ply
"$root/tests/bench/first_sight.py" --scancast "$bin/scancast" --sheet "$work/sheet.png" "${sights[@]}"
ffmpeg -v error -y -i "$work/sheet.png" -q:v 4 "$root/docs/images/first-sight.jpg"
[ -z "$only" ] || exit 0

"$bin/scancast" generate town --points 20M --origin 0,0,0 -o "$work/town.las"
render() { "$bin/scancast" render "$1" -o "$root/docs/images/$2.jpg" --width 1280 --height 720 --quality 85 "${@:3}"; }

render "$work/town.las" town
render "$work/town.las" square --eye=-1,-15,2.2 --target=0,-8.6,2.4 --fov 60
render "$work/town.las" intensity --color intensity --colormap viridis --shading eyedome

# docs/columns.md: what was built since, as a column, and all of it that is more than a metre away from what stood there.
"$bin/scancast" generate town --points 1M -o "$work/after.las"
"$bin/scancast" ingest "$work/after.las" -o "$work/after.scan" --exact --quiet
"$bin/scancast" export "$work/after.scan" -o "$work/before.las" --clips='-box:389500,5819836,60,60,24,60,20'
"$bin/scancast" ingest "$work/before.las" -o "$work/before.scan" --exact --quiet
"$bin/scancast" distance "$work/after.scan" "$work/before.scan" -o "$work/changes.scan" --max 6
for filter in auto distance:1..; do
    "$bin/scancast" render "$work/changes.scan" -o "$work/columns-${filter%%:*}.png" --width 640 --height 400 --eye=389478,5819755,72 --target=389505,5819850,44 --fov 40 \
        --color column:distance --colormap turbo --range 0,6 --shading phong --light occlusion=0.6 --filter "$filter"
done
ffmpeg -v error -y -i "$work/columns-auto.png" -i "$work/columns-distance.png" -filter_complex hstack -q:v 4 "$root/docs/images/columns.jpg"

# docs/clip.md.
"$bin/scancast" generate town --points 5M -o "$work/town5.las"
"$bin/scancast" render "$work/town5.las" -o "$root/docs/images/clip.jpg" --quality 80 --width 960 --height 400 --eye=389478,5819755,72 --target=389505,5819850,44 \
    --fov 40 --clips='plane:389500,5819836,0,0,1,0;-box:389535,5819846,45,30,24,60,30'
"$bin/scancast" render "$work/town5.las" -o "$root/docs/images/section.jpg" --quality 85 --width 960 --height 240 --clips='box:389500,5819800,50,240,0.6,60,20' \
    --projection orthographic --view-height 24 --eye=389534,5819706,43 --target=389500,5819800,43 --background '#ffffff'

# docs/several-clouds.md: the town, and a scan of it before that, which lies elsewhere.
"$bin/scancast" generate town --points 1M -o "$work/town1.las"
"$bin/scancast" generate town --points 400k --seed 7 -o "$work/before.las"
several() { "$bin/scancast" render "$work/town1.las" -o "$work/$1.png" --width 640 --height 400 --eye=389478,5819755,72 --target=389505,5819850,44 --fov 40 "${@:2}"; }
several by-cloud --color cloud*intensity --with "$work/before.las,shift:0:0:1.5"
several tinted --color rgb --with ".,tint:ffc080;$work/before.las,shift:0:0:1.5,tint:80c0ff"
ffmpeg -v error -y -i "$work/by-cloud.png" -i "$work/tinted.png" -filter_complex hstack -q:v 4 "$root/docs/images/several-clouds.jpg"

# A profile, cut out by a server.
"$bin/scancast" ingest "$work/town5.las" -o "$work/profile.scan" --quiet
"$bin/scancast" serve "$work/profile.scan" --port 18085 > /dev/null 2>&1 &
server=$!
until curl -sf http://127.0.0.1:18085/readyz > /dev/null; do sleep 0.2; done
"$bin/scancast-client" profile http://127.0.0.1:18085/ -o "$root/docs/images/profile.png" --width 1 --picture-width 1280 --point-size 2 \
    --exaggeration 1.5 --background '#ffffff' --line '389405,5819738;389480,5819760;389530,5819760'
kill "$server"

# Geoffrey Marchal's statue of Guanyin (CC BY 4.0), where it is at hand.
if [ -e "$scans/ply/guanyin-statue.ply" ]; then
    render "$scans/ply/guanyin-statue.ply" statue --eye=0.35,0.72,1.65 --target=0,0.62,0 --up=0,1,0 --fov 60
fi
