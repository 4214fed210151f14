"""Segmentations written by VTK, and byte by byte from the formats' definitions, must come back where their definitions
place them; damaged ones as one clear line: labelmap_oracle.py LABELMAP_POINTS"""
import gzip
import itertools
import struct
import subprocess
import sys
import tempfile

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkMetaImageWriter, vtkNIFTIImageWriter
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

SIZE = (7, 6, 5)  # i, j, k


def volume(dtype):
    """[k, j, i]: labels 0, 1, 2, 5 on no symmetric set"""
    a = np.zeros(SIZE[::-1], dtype)
    a[1:3, 2:5, 1:6] = 1
    a[3, 4, 6] = 2
    a[0, 0, 2:4] = 5
    return a


def rotation(x, y, z):
    c, s = np.cos((x, y, z)), np.sin((x, y, z))
    rx = np.array([[1, 0, 0], [0, c[0], -s[0]], [0, s[0], c[0]]])
    ry = np.array([[c[1], 0, s[1]], [0, 1, 0], [-s[1], 0, c[1]]])
    rz = np.array([[c[2], -s[2], 0], [s[2], c[2], 0], [0, 0, 1]])
    return rx @ ry @ rz


def run(path, *labels):
    return subprocess.run([sys.argv[1], path, *map(str, labels)], capture_output=True, text=True)


def check(what, path, columns, origin, array, labels=(), unit="mm"):
    result = run(path, *labels)
    assert result.returncode == 0, f"{what}: {result.stderr}"
    assert result.stderr == "", f"{what}: {result.stderr}"
    lines = result.stdout.splitlines()
    assert lines[0] == f"unit {unit}", f"{what}: {lines[0]}"
    got = np.array([[float(x) for x in line.split()] for line in lines[1:]])
    kji = np.argwhere(np.isin(array, labels) if labels else array > 0)
    wanted = kji[:, ::-1] @ np.asarray(columns).T + origin
    assert len(got) == len(wanted), f"{what}: {len(got)} voxels, not {len(wanted)}"
    off = np.linalg.norm(got[:, None] - wanted[None], axis=2).min(axis=1).max()
    assert off < 1e-4, f"{what}: voxels off by {off}"


def refuse(what, path, words, *labels):
    result = run(path, *labels)
    lines = result.stderr.splitlines()
    assert result.returncode == 2 and result.stdout == "", f"{what}: code {result.returncode}, {result.stderr}"
    assert len(lines) == 1 and path in lines[0], f"{what}: {result.stderr}"
    assert all(w in lines[0] for w in words), f"{what}: {lines[0]} has not {words}"


# --- NIfTI, from its definition (nifti1.h)
NIFTI_TYPES = {np.uint8: 2, np.int16: 4, np.int32: 8, np.float32: 16, np.float64: 64, np.int8: 256, np.uint16: 512}


def nifti(array, spacing, sform=None, qform=None, qfac=1.0, units=2, dims=None, offset=352):
    header = bytearray(348)
    struct.pack_into("<i", header, 0, 348)
    dims = dims or (3, *array.shape[::-1], 1, 1, 1, 1)
    struct.pack_into("<8h", header, 40, *dims)
    struct.pack_into("<2h", header, 70, NIFTI_TYPES[array.dtype.type], 8 * array.itemsize)
    struct.pack_into("<8f", header, 76, qfac, *spacing, 0, 0, 0, 0)
    struct.pack_into("<f", header, 108, offset)
    header[123] = units
    if qform is not None:  # quaternion b, c, d and offset
        struct.pack_into("<h", header, 252, 1)
        struct.pack_into("<6f", header, 256, *qform)
    if sform is not None:
        struct.pack_into("<h", header, 254, 2)
        struct.pack_into("<12f", header, 280, *np.asarray(sform).ravel())
    header[344:348] = b"n+1\0"
    return bytes(header) + bytes(offset - 348) + array.tobytes()


def quaternion_matrix(b, c, d):
    a = np.sqrt(1 - b * b - c * c - d * d)
    return np.array([[a * a + b * b - c * c - d * d, 2 * b * c - 2 * a * d, 2 * b * d + 2 * a * c],
                     [2 * b * c + 2 * a * d, a * a + c * c - b * b - d * d, 2 * c * d - 2 * a * b],
                     [2 * b * d - 2 * a * c, 2 * c * d + 2 * a * b, a * a + d * d - c * c - b * b]])


def test_nifti(folder):
    spacing, origin = (0.5, 0.7, 1.3), (10, -20, 30)
    for dtype, flip, qfac, packed in itertools.product(NIFTI_TYPES, (1, -1), (1.0, -1.0), (False, True)):
        array = volume(dtype)
        columns = rotation(0.3, -0.5, 1.1) @ np.diag((1, 1, flip)) @ np.diag(spacing)
        path = f"{folder}/s.nii" + (".gz" if packed else "")
        data = nifti(array, spacing, sform=np.c_[columns, origin], qfac=qfac)
        open(path, "wb").write(gzip.compress(data) if packed else data)
        check(f"sform {dtype} {flip} {qfac}", path, columns, origin, array)
    array = volume(np.uint8)
    for q, qfac in itertools.product(((0, 0, 0), (0.1, -0.3, 0.5), (0, 0, 1)), (1.0, -1.0)):
        columns = quaternion_matrix(*q) @ np.diag((spacing[0], spacing[1], qfac * spacing[2]))
        open(f"{folder}/q.nii", "wb").write(nifti(array, spacing, qform=(*q, *origin), qfac=qfac, units=3))
        check(f"qform {q} {qfac}", f"{folder}/q.nii", columns, origin, array, unit="um")
    # both: the sform wins
    columns = rotation(0.2, 0, 0) @ np.diag(spacing)
    open(f"{folder}/b.nii", "wb").write(nifti(array, spacing, np.c_[columns, origin], (0.1, 0.2, 0.3, 1, 2, 3)))
    check("sform and qform", f"{folder}/b.nii", columns, origin, array)
    # labels
    check("label 2", f"{folder}/b.nii", columns, origin, array, (2,))
    check("labels 1 and 5", f"{folder}/b.nii", columns, origin, array, (1, 5))
    refuse("unknown label", f"{folder}/b.nii", ["no voxel has the label 7", "1, 2, 5"], 1, 7)
    # dirty
    path = f"{folder}/bad.nii"

    def bad(what, data, *words, name=path):
        open(name, "wb").write(data)
        refuse(what, name, words)

    good = nifti(array, spacing, np.c_[columns, origin])
    bad("nothing", b"", "empty")
    bad("text", b"hello\n" * 100, "not NIfTI")
    bad("cut header", good[:200], "not NIfTI")
    bad("cut voxels", good[:-20], "cut off")
    bad("cut gzip", gzip.compress(good)[:-12], "cut off", name=path + ".gz")
    bad("no voxel", nifti(0 * array, spacing, np.c_[columns, origin]), "empty")
    four = np.stack([array, array])
    bad("4D", nifti(four, spacing, np.c_[columns, origin], dims=(4, *SIZE, 2, 1, 1, 1)), "4 dimensions")
    bad("2D", nifti(array[0], spacing, np.c_[columns, origin], dims=(2, 7, 6, 1, 1, 1, 1, 1)), "2 dimensions")
    grey = volume(np.float32) * 0.4
    bad("grey values", nifti(grey, spacing, np.c_[columns, origin]), "whole number", "voxel (2 0 0)" if grey[0, 0, 2] % 1 else "voxel")
    bad("not a number", nifti(grey * np.nan, spacing, np.c_[columns, origin]), "whole number")
    sheared = columns @ np.array([[1, 0.4, 0], [0, 1, 0], [0, 0, 1]])
    bad("sheared", nifti(array, spacing, np.c_[sheared, origin]), "right angles")
    refuse("no file", f"{folder}/none.nii", ["cannot be opened"])
    open(f"{folder}/a.tif", "wb").write(good)
    refuse("other format", f"{folder}/a.tif", [".nrrd"])


# --- NRRD, from its definition
NRRD_TYPES = {np.uint8: "unsigned char", np.int16: "short", np.uint16: "ushort", np.int32: "int", np.float32: "float"}


def nrrd(array, columns, origin, space, encoding="raw", big=False, **extra):
    directions = " ".join("(%.9g,%.9g,%.9g)" % tuple(c) for c in np.asarray(columns).T)
    fields = {"type": NRRD_TYPES[array.dtype.type], "dimension": "3", "space": space, "sizes": "%d %d %d" % array.shape[::-1],
              "space directions": directions, "kinds": "domain domain domain", "endian": "big" if big else "little",
              "encoding": encoding, "space origin": "(%.9g,%.9g,%.9g)" % tuple(origin), "space units": '"mm" "mm" "mm"'}
    fields.update({k.replace("_", " "): v for k, v in extra.items()})
    header = "NRRD0004\n# a comment\n" + "".join(f"{k}: {v}\n" for k, v in fields.items() if v) + "key:=value\n\n"
    data = (array.byteswap() if big else array).tobytes()
    return header.encode() + (gzip.compress(data) if encoding == "gzip" else data)


def test_nrrd(folder):
    path = f"{folder}/a.nrrd"
    columns = rotation(0.3, 0.2, -0.4) @ np.diag((0.5, 0.7, 1.3))
    origin = np.array((10, -20, 30))
    to_ras = {"left-posterior-superior": (-1, -1, 1), "LPS": (-1, -1, 1), "right-anterior-superior": (1, 1, 1),
              "left-anterior-superior": (-1, 1, 1), "scanner-xyz": (1, 1, 1)}
    for (space, signs), dtype, encoding, big in itertools.product(to_ras.items(), NRRD_TYPES, ("raw", "gzip"), (False, True)):
        array = volume(dtype)
        open(path, "wb").write(nrrd(array, columns, origin, space, encoding, big))
        check(f"nrrd {space} {dtype} {encoding} {big}", path, np.diag(signs) @ columns, origin * signs, array)
    array = volume(np.uint8)
    open(path, "wb").write(nrrd(array, columns, origin, "", space_directions="", space_origin="", space_units="",
                                spacings="1 2 3"))
    check("spacings", path, np.diag((1, 2, 3)), np.zeros(3), array, unit="")

    def bad(what, data, *words):
        open(path, "wb").write(data)
        refuse(what, path, words)

    bad("text", b"hello\n" * 100, "not NRRD")
    good = nrrd(array, columns, origin, "LPS")
    bad("cut", good[:-1], "cut off", "209", "210")
    bad("cut gzip", nrrd(array, columns, origin, "LPS", "gzip")[:-30], "cut off")
    bad("4D", nrrd(array, columns, origin, "LPS", dimension="4"), "4 dimensions")
    bad("no sizes", nrrd(array, columns, origin, "LPS", sizes=""), "sizes")
    bad("words", nrrd(array, columns, origin, "LPS", sizes="7 six 5"), "six")
    bad("bzip2", nrrd(array, columns, origin, "LPS", encoding="bzip2"), "bzip2", "raw or gzip")
    bad("block", nrrd(array, columns, origin, "LPS", type="block"), "type")
    bad("detached", nrrd(array, columns, origin, "LPS", data_file="a.raw"), "another file")
    bad("flat", nrrd(array, columns * (1, 1, 0), origin, "LPS"), "must be")
    bad("no direction", nrrd(array, columns, origin, "LPS", space_directions="(1,0,0) none (0,0,1)"), "must be")
    bad("endless header", b"NRRD0004\ntype: uchar\n", "no end")


# --- written by VTK
def vtk_image(array, spacing, origin, direction=None):
    image = vtkImageData()
    image.SetDimensions(*array.shape[::-1])
    image.SetSpacing(*spacing)
    image.SetOrigin(*origin)
    if direction is not None:
        for r, c in itertools.product(range(3), repeat=2):
            image.GetDirectionMatrix().SetElement(r, c, direction[r, c])
    scalars = numpy_to_vtk(array.ravel(), deep=1)
    scalars.SetName("labels")
    image.GetPointData().SetScalars(scalars)
    return image


def write(writer, image, path):
    writer.SetInputData(image)
    writer.SetFileName(path)
    writer.Write()


def test_vtk(folder):
    spacing, origin = np.array((0.5, 0.7, 1.3)), np.array((10.0, -20.0, 30.0))
    turn = rotation(0.3, -0.5, 1.1)
    for dtype in (np.uint8, np.int16, np.uint16, np.int32, np.float32, np.float64):
        array = volume(dtype)
        write(vtkXMLImageDataWriter(), vtk_image(array, spacing, origin, turn), f"{folder}/a.vti")
        check(f"vti {dtype}", f"{folder}/a.vti", turn @ np.diag(spacing), origin, array, unit="")
        lps = np.diag((-1, -1, 1))
        for name in ("a.mha", "a.mhd"):
            writer = vtkMetaImageWriter()
            writer.SetCompression(dtype == np.uint8)
            if name == "a.mhd":
                writer.SetRAWFileName(f"{folder}/a.zraw" if dtype == np.uint8 else f"{folder}/a.raw")
            write(writer, vtk_image(array, spacing, origin), f"{folder}/{name}")
            check(f"{name} {dtype}", f"{folder}/{name}", lps @ np.diag(spacing), lps @ origin, array)
    array = volume(np.uint8)
    write(vtkNIFTIImageWriter(), vtk_image(array, spacing, (0, 0, 0)), f"{folder}/w.nii.gz")
    check("NIfTI by VTK", f"{folder}/w.nii.gz", np.diag(spacing), np.zeros(3), array, unit="")
    # MetaImage turned: its rows are the directions of the axes
    head = (f"ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\n"
            f"TransformMatrix = {' '.join('%.12g' % x for x in turn.T.ravel())}\nOffset = 10 -20 30\n"
            "CenterOfRotation = 0 0 0\nElementSpacing = 0.5 0.7 1.3\nDimSize = 7 6 5\nElementType = MET_UCHAR\n"
            "ElementDataFile = LOCAL\n").encode()
    path = f"{folder}/turned.mha"
    open(path, "wb").write(head + array.tobytes())
    check("turned mha", path, lps @ turn @ np.diag(spacing), lps @ origin, array)
    open(path, "wb").write(head + array.tobytes()[:-10])
    refuse("cut mha", path, ["cut off"])
    open(path, "wb").write(head.replace(b"NDims = 3", b"NDims = 4") + array.tobytes())
    refuse("4D mha", path, ["4 dimensions"])
    open(path, "wb").write(b"hello")
    refuse("text mha", path, ["not MetaImage"])
    open(f"{folder}/bad.vti", "wb").write(open(f"{folder}/a.vti", "rb").read()[:-400])
    refuse("cut vti", f"{folder}/bad.vti", ["cut off"])
    image = vtk_image(array, spacing, origin)
    image.GetPointData().SetScalars(numpy_to_vtk(np.ones((array.size, 3), np.uint8), deep=1))
    write(vtkXMLImageDataWriter(), image, f"{folder}/rgb.vti")
    refuse("three values", f"{folder}/rgb.vti", ["3 values per voxel"])


def main():
    with tempfile.TemporaryDirectory() as folder:
        test_nifti(folder)
        test_nrrd(folder)
        test_vtk(folder)


main()
