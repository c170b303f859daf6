"""Bakes in Blender, for bench/bake: blender -b --factory-startup -P bake_blender.py -- FOLDER RESOLUTION CAGE.

Reads high.npz and low.npz (vertices, uvs, faces) and picture.png, writes blender.png, and prints the seconds of the call.
"""

import sys
import time

import bpy
import numpy as np

folder, resolution, cage = sys.argv[-3], int(sys.argv[-2]), float(sys.argv[-1])


def mesh_of(name):
    arrays = np.load(f"{folder}/{name}.npz")
    vertices, uvs, faces = arrays["vertices"], arrays["uvs"], arrays["faces"]
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", vertices.astype(np.float32).ravel())
    mesh.loops.add(faces.size)
    mesh.loops.foreach_set("vertex_index", faces.astype(np.int32).ravel())
    mesh.polygons.add(len(faces))
    mesh.polygons.foreach_set("loop_start", np.arange(0, faces.size, 3, dtype=np.int32))
    mesh.polygons.foreach_set("loop_total", np.full(len(faces), 3, np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(len(faces), bool))
    mesh.uv_layers.new().data.foreach_set("uv", uvs[faces].astype(np.float32).ravel())
    mesh.update(calc_edges=True)
    mesh.validate()
    item = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(item)
    return item


def add_material(item, image, emits):
    material = bpy.data.materials.new(item.name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    texture, output = nodes.new("ShaderNodeTexImage"), nodes.new("ShaderNodeOutputMaterial")
    texture.image, texture.extension = image, "EXTEND"
    if emits:
        emission = nodes.new("ShaderNodeEmission")
        links.new(texture.outputs["Color"], emission.inputs["Color"])
        links.new(emission.outputs["Emission"], output.inputs["Surface"])
    nodes.active = texture
    item.data.materials.append(material)


for item in list(bpy.data.objects):
    bpy.data.objects.remove(item)
begin = time.perf_counter()
high, low = mesh_of("high"), mesh_of("low")
add_material(high, bpy.data.images.load(f"{folder}/picture.png"), True)
result = bpy.data.images.new("result", resolution, resolution)
add_material(low, result, False)
high.select_set(True)
low.select_set(True)
bpy.context.view_layer.objects.active = low
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.device = "CPU"
scene.cycles.samples = 1
scene.cycles.use_denoising = False
ready = time.perf_counter()
bpy.ops.object.bake(type="EMIT", use_selected_to_active=True, cage_extrusion=cage, max_ray_distance=2 * cage,
                    margin=4, use_clear=True)  # fmt: skip
baked = time.perf_counter()
result.filepath_raw, result.file_format = f"{folder}/blender.png", "PNG"
result.save()
end = time.perf_counter()
print(f"blender: {ready - begin:.2f} s to make the meshes, {baked - ready:.2f} s to bake, {end - baked:.2f} s to write")
