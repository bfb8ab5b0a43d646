"""Makes the measured Cornell box's reference pictures with Mitsuba: python make.py SHARED_FOLDER

Writes cbox-rgb and cbox-spectral beside itself; README.md tells why.
"""

import os
import re
import sys

import mitsuba as mi
import numpy as np

SEEDS, SPP, WIDTH = 16, 256, 256
# Blocks of BLOCK x BLOCK pixels become one: with a box filter that is the smaller picture itself.
BLOCK = 4

shared = sys.argv[1]
here = os.path.dirname(os.path.abspath(__file__))


def scene(name):
    """The shared scene with independent samples."""
    with open(f"{shared}/reference/{name}/scene.xml") as file:
        return file.read().replace("ldsampler", "independent")


def observer():
    """The CIE 1931 observer from 360 to 830 nm in steps of 1 nm."""
    return np.loadtxt(f"{shared}/scenes/spectral/cie_1931_2deg_xyz.csv", delimiter=",")[:, 1:]


def film_of(bands):
    """A film whose channels are integrals of the light times each band."""
    spectra = "".join(
        f'<spectrum name="band{i}" type="regular"><float name="wavelength_min" value="360"/>'
        f'<float name="wavelength_max" value="830"/>'
        f'<string name="values" value="{", ".join(map(str, band))}"/></spectrum>'
        for i, band in enumerate(bands.T)
    )
    return (
        f'<film type="specfilm"><integer name="width" value="{WIDTH}"/><integer name="height" value="{WIDTH}"/>'
        f'<rfilter type="box"/><string name="component_format" value="float32"/>{spectra}</film>'
    )


def srgb_from_xyz():
    """By the primaries of Rec. 709 and the white point D65."""
    primaries = np.array([[0.64, 0.30, 0.15], [0.33, 0.60, 0.06], [0.03, 0.10, 0.79]])
    white = np.array([0.3127, 0.3290, 0.3583]) / 0.3290
    return np.linalg.inv(primaries * np.linalg.solve(primaries, white))


def make(name, variant):
    mi.set_variant(variant)
    mi.file_resolver().append(f"{shared}/scenes")
    text, matrix = scene(name), np.eye(3)
    if "spectral" in variant:
        bands = observer()
        text = re.sub('<film type="hdrfilm">.*?</film>', film_of(bands), text, flags=re.DOTALL)
        matrix = srgb_from_xyz() / bands[:, 1].sum()
    loaded = mi.load_string(text)
    side = WIDTH // BLOCK
    pictures = []
    for seed in range(SEEDS):
        pixels = np.array(mi.render(loaded, spp=SPP, seed=1000 + seed), dtype=np.float64)[..., :3]
        pictures.append((pixels @ matrix.T).reshape(side, BLOCK, side, BLOCK, 3).mean((1, 3)))
    folder = f"{here}/{name}"
    os.makedirs(folder, exist_ok=True)
    for file, values in [("mean", np.mean(pictures, 0)), ("var", np.var(pictures, 0, ddof=1) / SEEDS)]:
        mi.Bitmap(values.astype(np.float32)).write(f"{folder}/{file}.exr")


make("cbox-rgb", "llvm_ad_rgb")
make("cbox-spectral", "llvm_ad_spectral")
