#include "vtk/read_labelmap.h"

#include <vtkDataArray.h>
#include <vtkImageAlgorithm.h>
#include <vtkImageData.h>
#include <vtkMatrix3x3.h>
#include <vtkMatrix4x4.h>
#include <vtkMetaImageReader.h>
#include <vtkNIFTIImageHeader.h>
#include <vtkNIFTIImageReader.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkXMLImageDataReader.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "vasohex/core/error.h"
#include "vtk/labels.h"
#include "vtk/silence.h"

namespace vasohex {
namespace {

[[noreturn]] void fail(const std::string& what) { throw Error(ErrorCode::bad_input, what); }

VoxelType type_of(vtkDataArray& voxels) {
  const auto integer = [&](VoxelType plain, VoxelType positive, double least) { return least < 0 ? plain : positive; };
  const double least = voxels.GetDataTypeMin();
  switch (voxels.GetDataType()) {
    case VTK_FLOAT:
      return VoxelType::float32;
    case VTK_DOUBLE:
      return VoxelType::float64;
    case VTK_BIT:
      fail("voxels of one bit each, must be one byte or more");
    default:
      break;
  }
  switch (voxels.GetDataTypeSize()) {
    case 1:
      return integer(VoxelType::int8, VoxelType::uint8, least);
    case 2:
      return integer(VoxelType::int16, VoxelType::uint16, least);
    case 4:
      return integer(VoxelType::int32, VoxelType::uint32, least);
    default:
      return integer(VoxelType::int64, VoxelType::uint64, least);
  }
}

/// The voxels of what VTK has read, in VTK's own coordinates.
VoxelImage image_of(vtkImageData& data) {
  VoxelImage image;
  data.GetDimensions(image.size.data());
  vtkDataArray* voxels = data.GetPointData()->GetScalars();
  if (!voxels && data.GetPointData()->GetNumberOfArrays() == 1) {
    voxels = data.GetPointData()->GetArray(0);
  }
  if (!voxels || voxels->GetNumberOfTuples() == 0) {
    fail("it has no voxels (values at points)");
  }
  if (voxels->GetNumberOfComponents() != 1) {
    fail(std::to_string(voxels->GetNumberOfComponents()) + " values per voxel, must be one label");
  }
  if (voxels->GetNumberOfTuples() != static_cast<vtkIdType>(image.size[0]) * image.size[1] * image.size[2]) {
    fail("cut off: " + std::to_string(voxels->GetNumberOfTuples()) + " voxels, must be " +
         std::to_string(static_cast<long>(image.size[0]) * image.size[1] * image.size[2]));
  }
  image.type = type_of(*voxels);
  image.voxels = voxels->GetVoidPointer(0);
  double spacing[3], origin[3];
  data.GetSpacing(spacing);
  data.GetOrigin(origin);
  int extent[6];
  data.GetExtent(extent);
  for (int d = 0; d < 3; ++d) {
    for (int e = 0; e < 3; ++e) {
      image.columns(e, d) = data.GetDirectionMatrix()->GetElement(e, d) * spacing[d];
    }
    image.origin[d] = origin[d];
  }
  image.origin += image.columns * Vec3(extent[0], extent[2], extent[4]);
  return image;
}

/// In front of VTK's readers, which take much for granted: the text `key = value` lines of a MetaImage.
std::string meta_field(const std::string& path, const std::vector<std::string>& names) {
  std::ifstream file(path, std::ios::binary);
  for (std::string line; std::getline(file, line) && line.size() < 4096;) {
    const std::size_t equals = line.find('=');
    if (equals == std::string::npos) {
      break;
    }
    std::string key = line.substr(0, equals), value = line.substr(equals + 1);
    key.erase(key.find_last_not_of(" \t") + 1);
    value.erase(0, std::min(value.find_first_not_of(" \t"), value.size()));
    value.erase(value.find_last_not_of(" \t\r") + 1);
    for (const std::string& name : names) {
      if (key == name) {
        return value;
      }
    }
    if (key == "ElementDataFile") {
      break;
    }
  }
  return "";
}

std::vector<double> meta_numbers(const std::string& path, const std::vector<std::string>& names, std::size_t count) {
  std::istringstream words(meta_field(path, names));
  std::vector<double> result;
  for (double value; words >> value;) {
    result.push_back(value);
  }
  if (!result.empty() && result.size() != count) {
    fail(names.front() + " has " + std::to_string(result.size()) + " numbers, must be " + std::to_string(count));
  }
  return result;
}

void place_meta(const std::string& path, VoxelImage& image) {
  image.columns.setIdentity();
  image.origin.setZero();
  // rows of the file are the directions of the axes: columns of the map
  if (const auto m = meta_numbers(path, {"TransformMatrix", "Rotation", "Orientation"}, 9); !m.empty()) {
    image.columns = Eigen::Map<const Eigen::Matrix3d>(m.data());
  }
  if (const auto s = meta_numbers(path, {"ElementSpacing", "ElementSize"}, 3); !s.empty()) {
    image.columns = image.columns * Vec3(s[0], s[1], s[2]).asDiagonal();
  }
  if (const auto o = meta_numbers(path, {"Offset", "Position", "Origin"}, 3); !o.empty()) {
    image.origin = Vec3(o[0], o[1], o[2]);
  }
  lps_to_ras(image);
  image.units = "mm";
}

void place_nifti(vtkNIFTIImageReader& reader, VoxelImage& image) {
  vtkMatrix4x4* const to_world = reader.GetSFormMatrix() ? reader.GetSFormMatrix() : reader.GetQFormMatrix();
  if (to_world) {
    Eigen::Matrix3d turn;
    Vec3 shift;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        turn(r, c) = to_world->GetElement(r, c);
      }
      shift[r] = to_world->GetElement(r, 3);
    }
    image.columns = turn * image.columns;
    image.origin = turn * image.origin + shift;
  }
  switch (reader.GetNIFTIHeader()->GetXYZTUnits() & 7) {
    case 1:
      image.units = "m";
      break;
    case 2:
      image.units = "mm";
      break;
    case 3:
      image.units = "um";
      break;
    default:
      break;
  }
}

LabelVolume read(const std::string& path, const std::vector<int>& labels) {
  const auto ends_with = [&](const char* extension) { return path.ends_with(extension); };
  if (!std::ifstream(path, std::ios::binary)) {
    fail("cannot be opened, must be a readable file");
  }
  if (std::ifstream(path, std::ios::binary).peek() == std::ifstream::traits_type::eof()) {
    fail("is empty");
  }
  if (ends_with(".nrrd")) {
    std::vector<char> storage;
    const VoxelImage image = read_nrrd(path, storage);
    return pick_labels(image, labels);
  }
  const Silence silence;
  const auto update = [&](auto& reader) {
    reader.Update();
    if (silence.complained()) {
      fail("damaged or cut off: " + silence.complaint());
    }
  };
  if (ends_with(".nii") || ends_with(".nii.gz")) {
    vtkNew<vtkNIFTIImageReader> reader;
    if (!reader->CanReadFile(path.c_str())) {
      fail("not NIfTI: its header is missing or damaged");
    }
    reader->SetFileName(path.c_str());
    reader->UpdateInformation();
    if (silence.complained()) {
      fail("damaged or cut off: " + silence.complaint());
    }
    vtkNIFTIImageHeader& header = *reader->GetNIFTIHeader();
    const int dimensions = static_cast<int>(header.GetDim(0));
    for (int d = 4; d <= dimensions; ++d) {
      if (header.GetDim(d) > 1) {
        fail("it has " + std::to_string(dimensions) + " dimensions (" + std::to_string(header.GetDim(d)) +
             " volumes), must have 3");
      }
    }
    if (dimensions < 3) {
      fail("it has " + std::to_string(dimensions) + " dimensions, must have 3");
    }
    update(*reader);
    VoxelImage image = image_of(*reader->GetOutput());
    place_nifti(*reader, image);
    return pick_labels(image, labels);
  }
  if (ends_with(".mha") || ends_with(".mhd")) {
    const std::string dimensions = meta_field(path, {"NDims"});
    if (dimensions != "3") {
      fail(dimensions.empty() ? "not MetaImage: it has no NDims" : "it has " + dimensions + " dimensions, must have 3");
    }
    vtkNew<vtkMetaImageReader> reader;
    reader->SetFileName(path.c_str());
    update(*reader);
    VoxelImage image = image_of(*reader->GetOutput());
    place_meta(path, image);
    return pick_labels(image, labels);
  }
  if (ends_with(".vti")) {
    vtkNew<vtkXMLImageDataReader> reader;
    reader->SetFileName(path.c_str());
    update(*reader);
    return pick_labels(image_of(*reader->GetOutput()), labels);
  }
  fail("must end in .nii, .nii.gz, .nrrd, .mha, .mhd or .vti");
}

}  // namespace

LabelVolume read_labelmap(const std::string& path, const std::vector<int>& labels) {
  return with_context("segmentation " + path, [&] {
    LabelVolume volume = read(path, labels);
    check(volume);
    return volume;
  });
}

}  // namespace vasohex
