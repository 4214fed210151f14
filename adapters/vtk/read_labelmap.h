#pragma once
/// \file Reader of segmentations: NIfTI, NRRD, MetaImage, VTK image data (needs VTK).

#include <string>
#include <vector>

#include "vasohex/surface/label_volume.h"

namespace vasohex {

/// Reads a segmentation by the extension of its file: `.nii`, `.nii.gz`, `.nrrd` (one file, raw or gzip), `.mha`,
/// `.mhd`, `.vti`. Voxels whose label is one of `labels` are inside; if there are none, all with a label > 0.
///
/// World coordinates are RAS (x to the right of the patient, y to the front, z up) where the format has anatomical
/// ones: NIfTI by its sform, else its qform, else spacing alone; NRRD by its `space`, where left-posterior-superior is
/// turned into RAS and any other that is not anatomical stays; MetaImage is LPS by convention and turned. VTI stays.
/// Units: NIfTI's own; `mm` for MetaImage; NRRD's `space units`; otherwise not stated.
/// Voxels may be integers of any size, or floating-point numbers that are all whole.
///
/// Throws Error (bad_input): no such file, another format, damaged or cut off, not three-dimensional, several values
/// per voxel, values that are not whole, a label that no voxel has, nothing inside, axes not at right angles.
LabelVolume read_labelmap(const std::string& path, const std::vector<int>& labels = {});

}  // namespace vasohex
