"""What a look-up of a texture costs in OpenImageIO, as crates/render/benches/textures.rs has it for straal: 4096 x 4096 in 8 bits, one thread,
trilinear. The time of a call of the Python module without a look-up is taken off: a lower bound of its cost, so the rate told is an upper bound."""

import os
import tempfile
import time

import numpy as np
import OpenImageIO as oiio

SIDE, COUNT = 4096, 1 << 18

with tempfile.TemporaryDirectory() as folder:
    plain, tiled = os.path.join(folder, "noise.tif"), os.path.join(folder, "noise.tx")
    pixels = np.random.default_rng(1).integers(0, 256, (SIDE, SIDE, 4), dtype=np.uint8)
    out = oiio.ImageOutput.create(plain)
    out.open(plain, oiio.ImageSpec(SIDE, SIDE, 4, "uint8"))
    out.write_image(pixels)
    out.close()
    buffer = oiio.ImageBuf(plain)
    oiio.ImageBufAlgo.make_texture(oiio.MakeTxTexture, buffer, tiled, oiio.ImageSpec())
    system = oiio.TextureSystem()
    system.attribute("max_memory_MB", 1024.0)
    options = oiio.TextureOpt()
    options.mipmode = oiio.MipMode.Trilinear if hasattr(oiio, "MipMode") else options.mipmode
    rng = np.random.default_rng(2)
    for seen in (1.0, 3.0):
        step = seen / SIDE
        random = rng.random((COUNT, 2)).tolist()
        coherent = [[(i % 1000) * step, (i // 1000) * step] for i in range(COUNT)]
        for name, places in (("random", random), ("coherent", coherent)):
            for s, t in places[: COUNT // 8]:
                system.texture(tiled, options, s, t, step, 0.0, 0.0, step, 4)
            start = time.process_time()
            for s, t in places:
                system.texture(tiled, options, s, t, step, 0.0, 0.0, step, 4)
            taken = time.process_time() - start
            start = time.process_time()
            for s, t in places:
                system.texture("", options, s, t, step, 0.0, 0.0, step, 0)
            empty = time.process_time() - start
            rate = COUNT / max(taken - empty, 1e-9) / 1e6
            print(f"{name:10} {seen} texels: {taken / COUNT * 1e9:.0f} ns a call, {empty / COUNT * 1e9:.0f} ns without a texture: {rate:.1f} million a second at most")
