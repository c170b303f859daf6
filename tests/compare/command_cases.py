"""Command lines of sdm. `;` separates those that run one after another in the same folder, in which `in` has the inputs."""

COMMANDS = """
--help
--version
map --help
devices --json
nonsense
map
map in/ball.ply in/box.ply
map in/ball.ply in/box.ply -o out --no-such-option
map in/ball.ply in/box.ply -o out --resolution 64
map in/ball.ply in/box.ply -o out --resolution 64 --json --write none
map in/ball.ply in/box.ply -o out --resolution 64 --quiet --write exr
map in/ball.ply in/larger.ply -o out --resolution 64 --write views,exr,png,glb,html,texture,ply,csv,npy,vtp --units mm --tolerance 0.1
map in/larger.ply in/ball.ply -o out --resolution 64 --write exr,csv --tolerance 0.02
map in/larger.ply in/ball.ply -o out --resolution 64 --write csv --tolerance 0.02:0.07
map in/larger.ply in/ball.ply -o out --resolution 64 --write csv --tolerance=-0.01:0.045
map in/larger.ply in/ball.ply -o out --resolution 64 --write csv --tolerance 0.0500001
map in/larger.ply in/inverted.ply -o out --resolution 64 --write csv --tolerance 0.1
map in/ball.stl in/ball.off -o out --resolution 64 --write csv --tolerance 0.001
map in/ball.ply in/larger.ply -o out --resolution 64 --write csv --both --tolerance 0.1
map in/ball.ply in/beside.ply -o out --resolution 64 --write exr,csv,html --both --bands=-0.5,0,0.5,1
map in/ball.ply in/larger.ply -o out --precision 0.05 --write csv
map in/ball.ply in/larger.ply -o out --precision 0.05 --resolution 64
map in/ball.ply in/box.ply -o out --resolution 64 --write exr,csv --max-distance 0.5
map in/ball.ply in/box.ply -o out --resolution 64 --write csv --max-distance 0.5 --tolerance 0.4
map in/ball.ply in/apart.ply -o out --resolution 64 --write csv --max-distance 0.1
map in/ball.ply in/ground.ply -o out --resolution 64 --write csv --sign side
map in/ball.ply in/ground.ply -o out --resolution 64 --write csv --sign winding
map in/ball.ply in/ground.ply -o out --resolution 64 --write csv --sign exact
map in/ball.ply in/ground.ply -o out --resolution 64 --write csv --sign none --tolerance 3
map in/ball.ply in/ground.ply -o out --resolution 64 --write csv --tolerance 0:3
map in/ball.ply in/ground.ply -o out --resolution 64 --write csv --tolerance=-1:3
map in/ball.ply in/ground.ply -o out --resolution 64 --write csv --sign winding --tolerance=-1:9
map in/box2.ply in/box.ply -o out --write csv --tolerance 0.02 --precision 0.02
map in/box2.ply in/box.ply -o out --resolution 64 --write csv --tolerance 0.02
map in/ball.ply in/soup.ply -o out --resolution 64 --write exr,csv --sign winding --tolerance 2
map in/soup.ply in/ball.ply -o out --resolution 128 --write exr,csv
map in/dented.ply in/plate.ply -o out --resolution 64 --write exr,csv,html --tolerance 0.4
map in/dented.ply in/plate.ply -o out --resolution 64 --write exr,csv --facing --tolerance 0.4
map in/dented.ply in/plate.ply -o out --resolution 64 --write csv --facing 30 --tolerance 0.1
map in/dented.ply in/plate.ply -o out --resolution 64 --write csv --tolerance 0.4 --accept-doubts
map in/bent.ply in/plate.ply -o out --resolution 64 --write csv,html --facing --tolerance 0.5 --both
map in/ball.ply in/larger.ply -o out --resolution 64 --write csv --facing 200
map in/ground2.ply in/ground.ply -o out --resolution 64 --write exr,csv,html --along 0,0,1 --tolerance=-0.1:0.4
map in/ground2.ply in/ground.ply -o out --resolution 64 --write csv --along normal --tolerance 0.3
map in/dented.ply in/plate.ply -o out --resolution 64 --write csv --along normal --max-distance 1
map in/ground2.ply in/ground.ply -o out --resolution 64 --write csv --along 0,0,0
map in/ground2.ply in/ground.ply -o out --resolution 64 --along 0,0,1 --facing
map in/ground2.ply in/ground.ply -o out --precision 0.1 --along 0,0,1
map in/named.obj in/box2.ply -o out --resolution 64 --write csv --tolerance-table in/table.csv --align-on top
map in/named.obj in/box2.ply -o out --resolution 64 --write csv,html --tolerance-table in/table.csv
map in/named.obj in/box2.ply -o out --resolution 64 --write csv --tolerance-table in/table.json --tolerance 0.5
map in/named.obj in/box2.ply -o out --resolution 64 --write csv --tolerance-table in/table_semicolon.csv
map in/named.obj in/box2.ply -o out --resolution 64 --tolerance-table in/table_unknown.csv
map in/ball.ply in/box2.ply -o out --resolution 64 --tolerance-table in/table.csv
map in/named.obj in/box2.ply -o out --resolution 64 --write csv --bands=-0.02,0,0.02
map in/named.obj in/box2.ply -o out --resolution 64 --bands 0.1,0
map in/named.obj in/box2.ply -o out --resolution 64 --write csv --field part=4711 --field inspector=none --tolerance 0.1
map in/named.obj in/box2.ply -o out --resolution 128 --write exr,texture,png --atlas uv
map in/named.obj in/box2.ply -o out --resolution 128x64 --write exr,texture,csv --atlas uv
map in/named.obj in/box2.ply -o out --resolution 128x64 --write exr
map in/tiles.obj in/box2.ply -o out --resolution 64 --write exr,texture,csv --atlas uv
map in/tiles.obj in/box2.ply -o out --resolution 64 --atlas uv --strict-uv
map in/overlap.obj in/box2.ply -o out --resolution 64 --write exr,csv --atlas uv
map in/overlap.obj in/box2.ply -o out --resolution 64 --atlas uv --strict-uv
map in/ball.ply in/box.ply -o out --resolution 64 --atlas uv
map in/ball.ply in/box.ply -o out --resolution 128 --write exr,csv --atlas triangles --gutter 2
map in/ball.ply in/box.ply -o out --resolution 16 --write exr
map in/ball.ply in/box.ply -o out --resolution 8
map in/ball.ply in/box.ply -o out --resolution 128 --write exr --max-stretch 1.1 --gutter 0
map in/ball.ply in/box.ply -o out --resolution 64 --max-stretch 0.5
map in/ball.ply in/box.ply -o out --resolution 64 --write exr --atlas-cache cache ; map in/ball.ply in/box2.ply -o out --resolution 64 --write exr --atlas-cache cache
map in/ball.ply in/box.ply -o out --resolution 64 --write exr --atlas-cache cache ; map in/larger.ply in/box2.ply -o out2 --resolution 64 --atlas-cache cache
map in/ball.ply in/box.ply -o out --resolution 64 --write exr --channels distance,vector,site,face,position,barycentric,normal,closest
map in/ball.ply in/box.ply -o out --resolution 64 --write exr --channels nonsense
map in/ball.ply in/box.ply -o out --resolution 64 --write nonsense
map in/ball.ply in/box.ply -o out --resolution 32 --write views,png --colormap diverging --range -1 1 --up z
map in/ball.ply in/box.ply -o out --resolution 32 --write png,glb --colormap paper2006 --unlit --units in
map in/ball.ply in/box.ply -o out --resolution 32 --write png,glb --colormap viridis --picture-size 16
map in/ball.ply in/box.ply -o out --resolution 32 --range 1 0
map in/ball.ply in/box.ply -o out --resolution 64 --write exr,csv --engine reference
map in/ball.ply in/box.ply -o out --resolution 64 --write csv --engine gl
map in/ball.ply in/box.ply -o out --resolution 64 --write csv --engine gl --clip stencil --stencil-values 7 --no-bound-culling
map in/ball.ply in/box.ply -o out --resolution 64 --engine gl --device nowhere
map in/ball.ply in/box.ply -o out --resolution 64 --engine quantum
map in/plate.ply in/dented.ply -o out --resolution 64 --write csv --engine reference --facing
map in/ball.ply in/box.ply -o out --resolution 64 --write csv --threads 1
map in/ball.ply in/box.ply -o out --resolution 64 --write csv --transform-o1 fit --transform-o2 fit,translate:0.8:0:0
map in/ball.ply in/box.ply -o out --resolution 64 --write csv --transform-o1 rotate:0:90:0,scale:2,matrix:in/matrix.txt
map in/ball.ply in/box.ply -o out --resolution 64 --write csv --transform-o1 matrix:in/mirror.txt
map in/ball.ply in/box.ply -o out --resolution 64 --transform-o1 matrix:in/flat.txt
map in/ball.ply in/box.ply -o out --resolution 64 --transform-o1 shear:1
map in/scan.ply in/plate.ply -o out --resolution 64 --write csv,html --align --tolerance 0.1
map in/scan.ply in/plate.ply -o out --resolution 64 --write csv --align --align-from none --align-free xy,rz --align-about 5,5,0
map in/scan.ply in/plate.ply -o out --resolution 64 --write csv --align --align-from pca
map in/scan.ply in/plate.ply -o out --resolution 64 --write csv --align --align-on box:0,0,0,5,5,1 --tolerance 0.1
map in/scan.ply in/plate.ply -o a --resolution 64 --write none --align ; map in/scan.ply in/plate.ply -o b --resolution 64 --write csv --transform-o1 matrix:a/alignment.json
map in/scan.ply in/plate.ply -o out --resolution 64 --align-free xy
map in/scan.ply in/plate.ply -o out --resolution 64 --align --align-free q
map in/box2.ply in/named.obj -o out --resolution 64 --write csv --align --align-on top --align-on right
map in/box2.ply in/named.obj -o out --resolution 64 --align --align-on lid
map in/box2.ply in/box.ply -o out --resolution 64 --write csv --align-321 in/six.txt --tolerance 0.001
map in/box2.ply in/box.ply -o out --resolution 64 --align-321 in/poses.txt
map in/scan.ply in/plate.ply -o out --resolution 64 --write csv --align --min-coverage 0.9 --reach 0.1 --tolerance 0.1
map in/half.ply in/ball.ply -o out --resolution 64 --write csv --min-coverage 0.9 --tolerance 0.1
map in/half.ply in/ball.ply -o out --resolution 64 --write csv --min-coverage 0 --reach 0.05
map in/half.ply in/ball.ply -o out --resolution 64 --min-coverage 2
map in/box_inch.ply in/box.ply -o out --resolution 64 --write csv --units-o1 in --units-o2 mm --tolerance 0.01
map in/box_inch.ply in/box.ply -o out --resolution 64 --write csv --units-o1 in --units cm
map in/box_inch.ply in/box.ply -o out --resolution 64 --write csv --tolerance 2
map in/textured.glb in/ball.ply -o out --resolution 64 --write csv --units-o2 m --units mm --tolerance 0.001
map in/box.ply in/box.ply -o out --resolution 64 --units-o1 parsec
map in/specks.ply in/ball.ply -o out --resolution 64 --write csv --ignore-islands 20 --tolerance 0.01
map in/specks.ply in/ball.ply -o out --resolution 64 --write csv --ignore-islands 1%
map in/ball.ply in/specks.ply -o out --resolution 64 --write csv --ignore-islands-o2 area:0.1
map in/specks.ply in/ball.ply -o out --resolution 64 --ignore-islands 100%
map in/ball.ply in/unwelded.ply -o out --resolution 64 --write csv
map in/ball.ply in/unwelded.ply -o out --resolution 64 --write csv --weld auto
map in/ball.ply in/unwelded.ply -o out --resolution 64 --write csv --weld 1e-5
map in/ball.ply in/unwelded.ply -o out --resolution 64 --weld -1
map in/needle.ply in/ball.ply -o out --resolution 64 --write exr,csv
map in/missing.ply in/ball.ply -o out
map in/cut.ply in/ball.ply -o out
map in/index.obj in/ball.ply -o out
map in/nan.obj in/ball.ply -o out
map in/empty.obj in/ball.ply -o out
map in/no_area.obj in/ball.ply -o out
map in/unknown.xyzzy in/ball.ply -o out
map in/required.gltf in/ball.ply -o out
map in/cloud.xyz in/ball.ply -o out
map in/ball.ply in/box.ply -o in/ball.ply
map in/ball.ply in/box.ply -o out --tolerance nonsense
map in/ball.ply in/box.ply -o out --tolerance 1:0
self in/plate.ply -o out --resolution 64 --max-distance 1 --write exr,csv,html
self in/ball.ply -o out --resolution 64 --rings 2 --write exr,csv
self in/plate.ply -o out --resolution 64 --geodesic 3 --write csv --json
self in/boxes.ply -o out --resolution 64 --write csv
self in/plate.ply -o out --resolution 64 --geodesic 3 --rings 2
self in/plate.ply -o out --rings 0
thickness in/plate.ply -o out --resolution 64 --min 0.4 --write exr,csv,html
thickness in/dented.ply -o out --resolution 64 --min 0.4 --write exr,csv --units mm
thickness in/dented.ply -o out --resolution 64 --method ray --max 2 --write csv
thickness in/ball.ply -o out --resolution 64 --angle 45 --write csv --json
thickness in/ground.ply -o out
thickness in/plate.ply -o out --min 2 --max 1
points in/cloud.xyz in/ball.ply -o out
points in/cloud.csv in/ball.ply -o out --tolerance 0.02 --json
points in/cloud.csv in/ball.ply -o out --tolerance 0.005 --write ply --units mm
points in/comma.csv in/ball.ply -o out --tolerance 0:0.1
points in/comma.csv in/ball.ply -o out --decimal comma --separator semicolon --columns _,x,y,z --write none
points in/cloud.xyz in/ball.ply -o out --columns x,y,z,nx,ny,nz --facing --write ply --tolerance 0.1
points in/cloud.xyz in/ball.ply -o out --columns x,y,z,nx,ny,nz --along normal --tolerance 0.1 --write ply
points in/cloud.csv in/ball.ply -o out --along normal
points in/cloud.csv in/ball.ply -o out --along 0,0,1 --max-distance 0.5 --write ply
points in/cloud.xyz in/named.obj -o out --tolerance-table in/table.csv --write ply
points in/cloud.xyz in/ball.ply -o out --align --min-coverage 0.5 --reach 0.5 --tolerance 0.1 --write ply
points in/cloud.xyz in/ball.ply -o out --ignore-islands 3 --max-distance 0.001 --write ply
points in/odd.csv in/ball.ply -o out
points in/ball.ply in/ball.ply -o out
points in/cloud.xyz in/ground.ply -o out --sign side --write ply --field part=1
proximity in/ball.ply in/beside.ply
proximity in/ball.ply in/apart.ply --json
proximity in/ball.ply in/box.ply --contact-margin 0.1 --json
proximity in/ground.ply in/ball.ply --depth-precision 0.01 --json
proximity in/box.ply in/box2.ply --align --json
proximity in/ball.ply
hausdorff in/ball.ply in/larger.ply
hausdorff in/ball.ply in/box.ply --both --json
hausdorff in/dented.ply in/plate.ply --facing --json
hausdorff in/larger.ply in/ball.ply --tolerance 0.051 --units mm
hausdorff in/larger.ply in/ball.ply --tolerance 0.04
hausdorff in/ball.ply in/ball.ply --transform-o1 translate:0:0:2 --tolerance 2
hausdorff in/box_inch.ply in/box.ply --tolerance 2
hausdorff in/soup.ply in/ball.ply --precision 0.001 --json
hausdorff in/soup.ply in/ball.ply --precision 0
metrics in/ball.ply in/larger.ply --tolerance 0.01,0.1
metrics in/ball.ply in/box.ply --percentile 50,99 --json
metrics in/scan.ply in/plate.ply --tolerance 0.1 --fail-if hd95>0.01 --fail-if nsd(0.1)<0.5 --json
metrics in/ball.ply in/larger.ply --fail-if assd>1
metrics in/ball.ply in/larger.ply --fail-if hd95=1
bodies in/ball.ply in/beside.ply in/apart.ply --max-distance 2
bodies in/box.ply in/box.ply in/box.ply --poses in/poses.txt --contact-margin 0.1 --json
bodies in/ball.ply in/beside.ply in/apart.ply -o out --resolution 32 --json
bodies in/ball.ply
bodies in/box.ply in/box.ply --poses in/poses.txt
sequence in/walk in/box.ply -o out --resolution 64 --maps 2 --both
sequence in/walk in/box.ply -o out --resolution 64 --tolerance 1 --player --animation
sequence in/ball.ply+in/motion.npy in/larger.ply -o out --resolution 64 --json --contact-margin 0.1
sequence in/animated.glb in/box.ply -o out --resolution 64 --no-temporal --rate 4
sequence in/tear in/box.ply -o out --resolution 64 --allow-topology --maps 1
sequence in/tear in/box.ply -o out --resolution 64
sequence in/walk in/box.ply -o out --resolution 64 ; sequence in/walk in/box.ply -o out --resolution 64 --resume
sequence in/walk in/box.ply -o out --map-precision 0.1 --engine reference
bake in/textured.glb in/larger.ply -o out --resolution 64
bake in/colors.ply in/larger.ply -o out --resolution 64 --no-page --atlas triangles --json
bake in/named.obj in/box2.ply -o out --resolution 64 --no-page --channels base_color,face,material,position
bake in/dented.ply in/plate.ply -o out --resolution 64 --no-page --channels normal,object_normal,displacement,thickness,ambient_occlusion --occlusion-rays 8
bake in/dented.ply in/plate.ply -o out --resolution 64 --no-page --channels displacement --match ray --cage 1 --samples 4
bake in/textured.glb in/tiles.obj -o out --resolution 64 --no-page --facing --max-distance 5
bake in/ball.ply in/larger.ply -o out --resolution 64
simplify in/ball.ply -o low.ply --max-deviation 0.1
simplify in/dented.ply -o low.obj --triangles 40% --report report.json --lods 2
simplify in/textured.glb -o low.glb --triangles 100 --json
simplify in/ball.ply -o low.xyz --triangles 100
simplify in/ball.ply -o low.ply
volume in/ball.ply -o field.npy --spacing 0.2
volume in/ball.ply -o field.vti --grid 8 9 10 --sites --json
volume in/box.ply -o field.vdb --spacing 0.1 --max-distance 0.3
volume in/ground.ply -o field.npy --spacing 1 --sign winding --bounds 0 0 -1 10 10 1
volume in/ball.ply -o field.npy
info in/ball.ply
info in/soup.ply --self-intersections pairs.csv --json
info in/named.obj --json
info in/boxes.ply --json
info in/needle.ply
info in/textured.glb --json
info in/animated.glb
info in/cloud.xyz
info in/missing.ply
scene letters -o out --frames 3
scene letters -o out --frames 2 --format ply
scene scan -o out --mesh in/box.ply --triangles 500
scene nonsense -o out
""".strip().splitlines()
