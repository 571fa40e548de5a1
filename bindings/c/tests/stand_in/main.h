/* Declarations of the parts of ST's HAL that the example uses, to compile it without the HAL. */
#include <stdint.h>
typedef struct { volatile uint32_t CNT; } TIM_TypeDef;
typedef struct { TIM_TypeDef *Instance; } TIM_HandleTypeDef;
typedef struct { int unused; } DAC_HandleTypeDef;
typedef enum { HAL_OK, HAL_ERROR } HAL_StatusTypeDef;
#define TIM_CHANNEL_ALL 0x3Cu
#define DAC_CHANNEL_1 0x0u
#define DAC_ALIGN_12B_R 0x0u
#define __HAL_TIM_GET_COUNTER(handle) ((handle)->Instance->CNT)
HAL_StatusTypeDef HAL_DAC_SetValue(DAC_HandleTypeDef *dac, uint32_t channel, uint32_t alignment, uint32_t data);
HAL_StatusTypeDef HAL_DAC_Start(DAC_HandleTypeDef *dac, uint32_t channel);
HAL_StatusTypeDef HAL_TIM_Encoder_Start(TIM_HandleTypeDef *timer, uint32_t channel);
HAL_StatusTypeDef HAL_TIM_Base_Start_IT(TIM_HandleTypeDef *timer);
HAL_StatusTypeDef HAL_TIM_Base_Stop_IT(TIM_HandleTypeDef *timer);
void HAL_TIM_PeriodElapsedCallback(TIM_HandleTypeDef *timer);
