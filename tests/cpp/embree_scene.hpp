// A scene for Embree: geometry i is mesh i of the scene, and its primitives are the mesh's triangles.
#pragma once

#include "scene_copy.hpp"

#include <embree3/rtcore.h>

#include <cstring>

class EmbreeScene {
public:
    explicit EmbreeScene(const SceneCopy &copy) : device(rtcNewDevice(nullptr)), scene(rtcNewScene(device)) {
        rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
        for (const MeshCopy &mesh : copy.meshes) {
            RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
            void *vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                     3 * sizeof(float), mesh.positions.size() / 3);
            std::memcpy(vertices, mesh.positions.data(), mesh.positions.size() * sizeof(float));
            void *triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                      3 * sizeof(std::uint32_t), mesh.triangles());
            std::memcpy(triangles, mesh.indices.data(), mesh.indices.size() * sizeof(std::uint32_t));
            rtcCommitGeometry(geometry);
            rtcAttachGeometry(scene, geometry);
            rtcReleaseGeometry(geometry);
        }
        rtcCommitScene(scene);
        CHECK(rtcGetDeviceError(device) == RTC_ERROR_NONE);
    }
    ~EmbreeScene() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
    EmbreeScene(const EmbreeScene &) = delete;
    EmbreeScene &operator=(const EmbreeScene &) = delete;

    RTCRayHit closest(const float origin[3], const float direction[3], float near, float far) const {
        RTCRayHit query = {};
        query.ray.org_x = origin[0];
        query.ray.org_y = origin[1];
        query.ray.org_z = origin[2];
        query.ray.dir_x = direction[0];
        query.ray.dir_y = direction[1];
        query.ray.dir_z = direction[2];
        query.ray.tnear = near;
        query.ray.tfar = far;
        query.ray.mask = ~0u;
        query.hit.geomID = query.hit.primID = RTC_INVALID_GEOMETRY_ID;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(scene, &context, &query);
        return query;
    }

    // Whether anything lies on the segment between the points, end points excluded.
    bool blocked(Vec from, Vec to) const {
        const Vec d = to - from;
        RTCRay ray = {};
        ray.org_x = float(from.x);
        ray.org_y = float(from.y);
        ray.org_z = float(from.z);
        ray.dir_x = float(d.x);
        ray.dir_y = float(d.y);
        ray.dir_z = float(d.z);
        ray.tnear = 0;
        ray.tfar = 0.9999f;
        ray.mask = ~0u;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcOccluded1(scene, &context, &ray);
        return ray.tfar < 0;
    }

private:
    RTCDevice device;
    RTCScene scene;
};
